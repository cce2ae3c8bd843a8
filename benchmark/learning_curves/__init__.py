"""Learning curves: own error of each data set's leaders against the poses that calibrate them."""
