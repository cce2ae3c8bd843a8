"""How good a prediction is: accuracy, repeatability, availability, distance from the bound."""
