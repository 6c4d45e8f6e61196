"""`python -m experiments.command`: the same as `pounding`."""

from experiments.command.app import main

if __name__ == "__main__":
    main()
