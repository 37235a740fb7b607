"""``python -m cablemodel`` is the command line."""

from cablemodel.cli import main

if __name__ == "__main__":
    main()
