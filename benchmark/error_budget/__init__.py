"""Which part of the chain holds a data set's best pipeline back: measured, tabled, said."""
