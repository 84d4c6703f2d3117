"""Mobile manipulator: a platform with joints on it."""

from __future__ import annotations

from dataclasses import dataclass, fields

from .base import Drive, DrivePart
from .joint_velocity import JointVelocity
from .platform import Platform

OWN_LIMITS = JointVelocity()  # none beside those of the joints


@dataclass(frozen=True)
class MobileManipulator(Drive):
    """A platform with joints on it: the platform's action, then the joints'."""

    kind = "mobile_manipulator"

    platform: Platform
    joints: JointVelocity = OWN_LIMITS

    def __post_init__(self) -> None:
        for item, expected in zip(fields(self), (Platform, JointVelocity), strict=True):
            value = getattr(self, item.name)
            if not isinstance(value, expected):
                raise TypeError(
                    f"MobileManipulator: {item.name}: got {type(value).__name__}, expected a"
                    f" {expected.__name__}"
                )

    @property
    def parts(self) -> tuple[DrivePart, ...]:
        """The platform, then the joints."""
        return (self.platform, self.joints)
