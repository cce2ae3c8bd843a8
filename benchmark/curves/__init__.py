"""Learning curves: error of each data set's leaders against the poses that calibrate them."""
