"""Systems as readable files: system.toml."""
