"""`python -m cosim`."""

from cosim.command.main import main

main()
