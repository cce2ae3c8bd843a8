"""The mapping of studies: one study with its values, the tables it is read from, the advice."""
