"""What a host that is not Python needs to run the FMUs."""
