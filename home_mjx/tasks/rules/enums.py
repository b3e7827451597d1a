"""Capacities of a row, and enumerations of the codes in its columns."""

from home_mjx.core.named_enum import NamedIntEnum

NUM_DESCRIPTORS = 4  # objects, rooms, places or agents that a row refers to
NUM_CONDITIONS = 8
NUM_STAGES = 6
NUM_TRANSITIONS = 4  # per stage
NUM_TOKENS = 32  # of the instruction
NUM_REPLIES = 6  # of the oracle
MAX_AGENTS = 15  # maximum number of agents: bits of the column `instructed_agents`

ANY = -1  # in a descriptor: any value; elsewhere: none
ALL_AGENTS = -1  # in the column `instructed_agents`
NO_WORD = -1  # token of no word
SUCCESS, FAILURE = -1, -2  # stages that end an episode


class TargetKind(NamedIntEnum):
    """Kind of a descriptor's target."""

    NOTHING = -1
    OBJECT = 0
    ROOM = 1
    PLACE = 2
    AGENT = 3


class Attribute(NamedIntEnum):
    """Columns of a descriptor: its kind, and the properties that all targets share; `ANY` if unconstrained."""

    KIND = 0
    FINE = 1  # index into FINE
    COARSE = 2  # index into COARSE
    COLOR = 3  # index into the palette of 16; any of an object's main colours
    MATERIAL = 4  # index into MATERIAL_KINDS
    SIZE = 5  # index into SIZES
    ROOM_TYPE = 6  # index into ROOM_TYPES; any label of a room, or of the room that an object is in
    OBJECT_ID = 7  # one object of the house
    ROOM = 8  # one room of the house, or the room that an object is in
    ON = 9  # index of another descriptor of the row: rests on one of its targets
    IN = 10  # likewise: is inside one of its targets
    AGENT = 11  # index of an agent


class Feature(NamedIntEnum):
    """Quantity that a condition tests; `i` and `j` are its descriptors."""

    TRUE = 0  # always 1
    DISTANCE = 1  # [m], along the shortest path to the nearest i
    STRAIGHT = 2  # [m], in a straight line to the nearest i at its present place
    SEEN = 3  # 1: the nearest i is in view
    HELD = 4  # 1: the agent holds an i
    INSIDE = 5  # 1: the agent is in room i
    BESIDE = 6  # [m], minimum gap between an i and a j at their present places
    ON = 7  # 1: an i rests on a j
    OPEN = 8  # widest opening of the doors i, 0 shut to 1 wide
    STOPPED = 9  # 1: the agent has chosen `stop`
    TIME = 10  # steps since the stage began
    TOUCHED = 11  # 1: the agent touched anything but the floor in the last step
    CLEAR = 12  # 1: the line of sight to the nearest i is free, whatever the agent's heading
    SAID = 13  # token of the word that the agent said in the last step; -1 if none
    SWITCHED_ON = 14  # 1: an i is on; 0 with nothing to switch
    CONTAINED = 15  # compartment of the furniture j that an i is in, by its index in the house; -1 none


class Purpose(NamedIntEnum):
    """Purpose of going to an object; it determines the end cells of paths."""

    LOOK = 0
    TAKE = 1  # a condition requires that it is held
    PUT = 2  # a condition requires that an object rests on it
    TOGGLE = 3  # a condition is about its state, on or off
