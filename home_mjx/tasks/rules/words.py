"""What the numbers of a row stand for."""

from enum import IntEnum

NUM_DESCRIPTORS = 4  # things, rooms or places that a row speaks of
NUM_CONDITIONS = 8
NUM_STAGES = 6
NUM_TRANSITIONS = 4  # out of each stage
NUM_TOKENS = 32  # of the instruction

ANY = -1  # in a descriptor: whatever it is; elsewhere: none
SUCCESS, FAILURE = -1, -2  # stages that end an episode


class Kind(IntEnum):
    """What a descriptor speaks of."""

    NOTHING = -1
    OBJECT = 0
    ROOM = 1
    PLACE = 2
    AGENT = 3


class Word(IntEnum):
    """Columns of a descriptor: its kind, and what all that it means have in common; `ANY` where it does not matter."""

    KIND = 0
    FINE = 1  # index into FINE
    COARSE = 2  # index into COARSE
    COLOR = 3  # index into the palette of 16; any of an object's main colours
    MATERIAL = 4  # index into MATERIAL_KINDS
    SIZE = 5  # index into SIZES
    ROOM_TYPE = 6  # index into ROOM_TYPES; of a room, or of the room that an object is in
    OBJECT_ID = 7  # one object of the house
    ROOM = 8  # one room of the house, or the room that an object is in
    ON = 9  # number of another descriptor of the row: stands or lies on one of these
    IN = 10  # alike: is in one of these
    AGENT = 11  # number of an agent


class Feature(IntEnum):
    """What a condition looks at; `i` and `j` are its descriptors."""

    TRUE = 0  # 1
    DISTANCE = 1  # [m], along the shortest path to the nearest i
    STRAIGHT = 2  # [m], to the nearest i where it is now, in a straight line
    SEEN = 3  # 1: the nearest i is in view
    HELD = 4  # 1: the agent holds an i
    INSIDE = 5  # 1: the agent is in room i
    BESIDE = 6  # [m], least gap between an i and a j where they are now
    ON = 7  # 1: an i rests on a j
    OPEN = 8  # widest opening of the doors i, 0 shut to 1 wide
    STOPPED = 9  # 1: the agent has chosen `stop`
    TIME = 10  # steps since the stage began
    TOUCHED = 11  # 1: the agent touched anything but the floor in the last step
    CLEAR = 12  # 1: nothing is between the agent's eyes and the nearest i, whichever way it looks
    SAID = 13  # token of the word that the agent said in the last step; -1 none


class Use(IntEnum):
    """What an agent goes to a thing for, which says where it goes to."""

    LOOK = 0
    TAKE = 1  # a condition asks that it be held
    PUT = 2  # a condition asks that something be on it
