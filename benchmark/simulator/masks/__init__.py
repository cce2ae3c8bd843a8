"""Masks as data: apertures, their layouts, their codes and their errors."""
