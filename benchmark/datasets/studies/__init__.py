"""Sensors of single studies, one module each: run by the studies that they follow, and no others.

They stand on no board: the standard data sets compare methods, these show a study's own run on the
sensor that it states.
"""
