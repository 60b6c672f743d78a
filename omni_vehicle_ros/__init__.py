"""An omni-directional road vehicle, steered by wire through its instantaneous centre of rotation."""

__version__ = '0.1.0'
