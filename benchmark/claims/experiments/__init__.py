"""One module a claim, by what is tested; shared parts beside them."""
