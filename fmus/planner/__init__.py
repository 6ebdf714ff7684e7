"""Time-optimal planning before the drive: README.md. A library; `hocp.plan` is the entry."""
