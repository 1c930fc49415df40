"""The command line, as ``python -m tetropolis``."""
from tetropolis_command import main

if __name__ == "__main__":
    main()
