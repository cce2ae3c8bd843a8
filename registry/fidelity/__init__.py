"""How near what runs of a study is to it: purposes, settings, departures, grades."""
