"""Group X: the model description. One module per topic."""
