"""What goes wrong by a user's doing, said in one line that names the value, the limit and the remedy."""


class OmniVehicleError(Exception):
    """Base of every error that this package raises on purpose; the command line prints it and exits with 2."""


class ParameterError(OmniVehicleError):
    """A parameter is unknown, of the wrong type or outside its range."""


class ScenarioError(OmniVehicleError):
    """A scenario is unknown, malformed or inconsistent."""


class FaultError(OmniVehicleError):
    """A fault is unknown, or its value outside its limits."""


class CommandError(OmniVehicleError):
    """A driver command can't be followed: not finite, in a wrong frame, or outside the vehicle's reach."""


class BagError(OmniVehicleError):
    """A bag can't be written or read, or lacks what is needed."""


class RunError(OmniVehicleError):
    """A run could not be started or did not end as it should."""


class MessageError(OmniVehicleError):
    """Bytes are not a message of the type that they should be, or a value doesn't fit into its message."""
