"""Neural networks: one hidden layer an axis (ANN), several hidden layers (DNN)."""
