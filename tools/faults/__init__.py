"""Damaged files tried on every reader: ``make faults``, no part of the tests."""
