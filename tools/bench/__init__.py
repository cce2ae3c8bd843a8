"""Benchmarks of speed and accuracy for asv: `make bench` (`tools/asv.conf.json`)."""
