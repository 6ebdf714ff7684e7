"""One run of a scenario: what was asked for, what is going to run, and running it into a folder."""
