"""`python -m pounding`: the same as the command `pounding`, of the Python that is named."""

from pounding.experiments.command import main

if __name__ == "__main__":
    main()
