"""XMP of a picture: the attitude and the optics of its camera in the namespace that mapping software reads.

Yaw, pitch and roll turn an aircraft that carries the camera looking down, one after the other about its own axes
(z-y'-x'' with x ahead, y to the right, z down): all 0 is a picture of the ground below with north at its top, pitch 90
looks ahead. They are the yaw, tilt and roll of `Camera.rays_enu` as they are, and the angles that OpenSfM and
OpenDroneMap take them for (Bäumker and Heimes 2001).
"""

from __future__ import annotations

from .description import Description
from .digits import accuracy, degrees, figure
from .exposure import Exposure

NAMESPACE = "http://pix4d.com/camera/1.0/"


def xmp(description: Description, exposure: Exposure) -> bytes:
    """XMP packet (ISO 16684-1) with the names of the ``Camera`` namespace as attributes, in one line.

    OpenSfM searches for the element ``x:xmpmeta`` in the text that Python makes of the file's bytes, where a line's end
    is no white space.
    """
    length = exposure.body.focal_length_mm
    x_mm, y_mm = (at * length / focal for at, focal in zip(exposure.centre_px, exposure.focal_px))
    across_m, in_height_m = exposure.accuracy_m
    values = {
        "Yaw": repr(degrees(description.yaw_deg)),
        "Pitch": repr(degrees(description.tilt_deg)),
        "Roll": repr(degrees(description.roll_deg)),
        "GPSXYAccuracy": repr(accuracy(across_m)),
        "GPSZAccuracy": repr(accuracy(in_height_m)),
        "ModelType": "perspective",
        "PrincipalPoint": f"{figure(x_mm)!r},{figure(y_mm)!r}",
        "PerspectiveFocalLength": repr(figure(length)),
        "AboveGroundAltitude": repr(figure(description.agl_m)),
    }
    attributes = " ".join(f'Camera:{name}="{value}"' for name, value in values.items())
    return (
        '<?xpacket begin="\ufeff" id="W5M0MpCehiHzreSzNTczkc9d"?>'
        '<x:xmpmeta xmlns:x="adobe:ns:meta/"><rdf:RDF xmlns:rdf="http://www.w3.org/1999/02/22-rdf-syntax-ns#">'
        f'<rdf:Description rdf:about="" xmlns:Camera="{NAMESPACE}" {attributes}/>'
        '</rdf:RDF></x:xmpmeta><?xpacket end="r"?>'
    ).encode()
