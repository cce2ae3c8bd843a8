"""Taking the authors' own table."""
