"""The report of a calibration: numbers, pictures and the page that is signed."""
