"""Draws the report page of the README: `python docs/build_helpers/pictures.py`.

The picture of the window comes from `tests/benchmarks/window_pictures.py`.
"""

import subprocess
import sys
from pathlib import Path
from tempfile import TemporaryDirectory

import designer

TARGET = Path(designer.__file__).parent / "examples" / "pictures" / "report-yard.png"


def main():
    """Make the report of the yard crane, and a picture of its first page."""
    with TemporaryDirectory() as folder:
        study = designer.read_study(designer.example_file("yard"), with_plugins=False)
        analysis = designer.analyse(study, designer.catalogue(with_plugins=False))
        designer.write_report(analysis, folder)
        page = ["-f", "1", "-l", "1", "-r", "80", "-png", "-singlefile"]
        made = TARGET.with_suffix("")
        subprocess.run(["pdftoppm", *page, Path(folder, "report.pdf"), made], check=True)
    print(TARGET, file=sys.stderr)


main()
