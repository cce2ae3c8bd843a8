"""Forms of a file of readings: text and its layout, units, cells, attitudes, names of columns."""
