"""``python -m designer``."""

from designer.cli.commands import main

if __name__ == "__main__":
    main()
