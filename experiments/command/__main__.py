"""`python -m pounding.experiments.command`: the same as `pounding`."""

from pounding.experiments.command import main

if __name__ == "__main__":
    main()
