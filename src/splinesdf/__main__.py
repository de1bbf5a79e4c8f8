"""``python -m splinesdf``."""

from splinesdf.cli import main

main()
