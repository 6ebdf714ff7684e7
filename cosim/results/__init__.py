"""What a run leaves: recorded signals, the summary, and reading both back."""
