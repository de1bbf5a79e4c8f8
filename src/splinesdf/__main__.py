"""``python -m splinesdf``."""

from splinesdf.cli.main import main

main()
