"""The `fmus` command: a module for each subcommand that needs the catalogue."""
