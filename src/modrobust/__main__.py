"""``python -m modrobust`` runs the command line."""

from modrobust.cli import main

if __name__ == "__main__":
    main()
