"""Rules on the joints of models: models and faces exist, and no face has two joints."""

from itertools import pairwise

from home_mjx.datasets.suncg.read.joints import JOINTS
from home_mjx.datasets.suncg.validate.subject import ValidationContext
from home_mjx.schema.house import Joint, Mesh


def check_joints(subject: ValidationContext) -> None:
    """Check for joints of unknown models; in models of the house, for missing faces and faces of two parts."""
    for model_id, joints in subject.joints.items():
        if subject.metadata is not None and model_id not in subject.metadata.models:
            _report(subject, "joint-model", model_id, "the model has no row in the category table")
        mesh = subject.house.models.get(model_id)
        if mesh is not None:
            _check_faces(subject, joints, mesh)


def _check_faces(subject: ValidationContext, joints: tuple[Joint, ...], mesh: Mesh) -> None:
    for joint in joints:
        if joint.face_ranges[-1][1] >= len(mesh.faces):
            message = f"face {joint.face_ranges[-1][1]} of a model that has {len(mesh.faces)}"
            _report(subject, "joint-faces", f"{joint.model_id} {joint.part}", message)
    runs = sorted((*run, joint.part) for joint in joints for run in joint.face_ranges)
    for (_, last, part), (first, _, other) in pairwise(runs):
        if first <= last:
            _report(subject, "joint-faces", f"{joints[0].model_id} {other}", f"face {first} is of {part} as well")


def _report(subject: ValidationContext, rule: str, element: str, message: str) -> None:
    subject.report(rule, element, message, subject.reading.assets.root / "metadata" / JOINTS)
