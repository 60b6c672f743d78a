"""Write docs/demo.svg, the picture of the README: the path of a run from above."""

import sys
from pathlib import Path

import matplotlib

from omni_vehicle_ros.analysis.path import plot_path
from omni_vehicle_ros.analysis.style import house_style
from omni_vehicle_ros.bags import open_bag


def main() -> None:
    """Draw the run whose directory is named."""
    matplotlib.use('svg')
    from matplotlib import pyplot

    with house_style():
        figure, axes = pyplot.subplots(figsize=(8.0, 5.8), layout='constrained')
        plot_path(open_bag(Path(sys.argv[1]) / 'bag'), axes)
        figure.savefig('docs/demo.svg', metadata={'Date': None})


if __name__ == '__main__':
    main()
