"""Words of requests in English, German, Spanish and Chinese: regular expressions for :func:`.language.plain` text."""

from __future__ import annotations

import re

__all__ = [
    "BEHAVIORS", "DIRECTIONS", "DRIVES", "LAYOUTS", "NOT_FLAT", "NOUNS", "NO_BEHAVIOR", "UNKNOWN_REFERENCE",
    "first", "has",
]  # fmt: skip

NOUNS: dict[str, str] = {
    "person": r"pedestrians?|people|persons?|humans?|walkers?|bystanders?|visitors?|shoppers?|passers-?by|strollers?"
    r"|fußgänger\w*|person(?:en|as?)|passanten?|menschen|leute|peat(?:ón|ones)|peatones|transeúntes?|gente|行人|路人",
    "lidar": r"lidars?|laser ?scanners?|scanners?|激光雷达|雷达",
    "wall": r"walls?|wände?n?|wand|mauern?|pared(?:es)?|muros?|墙壁?",
    "corridor": r"corridors?|hallways?|passageway|korridors?|flur|gang|pasillos?|corredor(?:es)?|走廊|通道",
    "doorway": r"doorways?|doors?|opening|gap|tür(?:en|öffnung)?|durchgang|puertas?|abertura|门洞|门口|门",
    "ring": r"circle of radius|on an? circle|around an? circle|in an? circle|kreis|círculo|圆周|圆圈|圆上",
    "world": (
        r"worlds?|arenas?|rooms?|halls?|fields?|plazas?|maps?|yard|hangar"
        r"|welt|halle|raum|feld|platz|karte|fläche|mundo|sala|campo|plaza|mapa|salón"
        r"|nave|世界|场景|场地|房间|大厅|地图|广场"
    ),
    "robot": r"robots?|vehicles?|cars?|trucks?|agv|agvs|bases?|platforms?|forklifts?|rovers?|ones"
    r"|\w*roboters?n?|\w*fahrzeuge?n?s?|autos?|plattform(?:en)?|vehículos?|coches?|carros?|机器人|小车|车辆|汽车|车",
    "obstacle": (
        r"obstacles?|box(?:es)?|crates?|posts?|pillars?|columns?|blocks?|barrels?"
        r"|shel(?:f|ves)|racks?|tables?"
        r"|pallets?|polygons?|hindernisse?n?|säulen?|kisten?|pfosten|blöcke?|regale?"
        r"|pfeiler|tische?"
        r"|obstáculos?|cajas?|columnas?|pilares?|postes?|bloques?|estanter\w+|mesas?"
        r"|障碍物|柱子|箱子|方块|正方形|货架|立柱"
    ),
    "trap": r"u-shaped trap|u-shaped|u-trap|u-förmig\w*|en forma de u|u ?形",
}
"""Things that a request speaks of. The order decides which wins where two match at one place."""

DRIVES: dict[str, str] = {
    "omni_angular": (
        r"(?:omnidirectional|holonomic|omni|mecanum)[^.;]{0,40}"
        r"(?:also (?:rotate|turn)|and (?:can )?(?:rotate|turn)|yaw)"
    ),
    "diff": (
        r"diff(?:erential)?[- ]?(?:drive|wheel\w*)?|two-wheeled|turtlebot|roomba|differential\w*"
        r"|zweirädrig\w*|diferencial(?:es)?|差速"
    ),
    "acker": r"ackermann?|car-like|cars?|truck|bicycle model|autos?|coches?|阿克曼|汽车",
    "omni": r"holonom\w*|omnidirec\w*|omni\b|mecanum|omnidirektional\w*|全向",
}
"""Drive → words."""

BEHAVIORS: dict[str, str] = {
    "rvo": r"\brvo\b|reciprocal velocity|velocidad recíproca|互惠速度",
    "orca": r"\borca\b",
    "sfm": r"\bsfm\b|social[- ]force|sozialkraft\w*|soziale\w* kr[aä]ft\w*|fuerzas? social(?:es)?|社会力",
    "follow": (
        r"plan(?:s|ned)? (?:a|its|the) (?:path|route|way)|path planner|a\*|global planner"
        r"|geplante\w* (?:pfad|weg)|规划"
    ),
    "dash": (
        r"\bdash\b|greedy|go-straight|straight (?:to|towards?|at)|drives? directly"
        r"|directly to|geradewegs|directo a|直线"
    ),
}
"""Behavior → words."""
NO_BEHAVIOR = (
    r"without (?:a |any |built-in )*behaviou?rs?|no (?:built-in )?behaviou?rs?|leave .{0,30}without a behaviou?r"
    r"|my (?:own )?(?:policy|controller|planner)[^.]{0,40}(?:supplies|drives|controls|plugs?|acts)|plug in my own"
    r"|ohne verhalten|sin comportamiento|不要行为|没有行为"
)
"""Words that say that the user's program drives."""

DIRECTIONS: list[tuple[str, tuple[float, float]]] = [
    (
        (
            r"(?:north-?|top[- ]|upper[- ])east|(?:top|upper)[- ]right|nordost\w*|oben rechts"
            r"|noreste|arriba a la derecha|东北|右上"
        ),
        (1, 1),
    ),
    (r"(?:north-?)west|(?:top|upper)[- ]left|nordwest\w*|oben links|noroeste|西北|左上", (-1, 1)),
    (r"(?:south-?)east|(?:bottom|lower)[- ]right|südost\w*|unten rechts|sureste|东南|右下", (1, -1)),
    (r"(?:south-?)west|(?:bottom|lower)[- ]left|südwest\w*|unten links|suroeste|西南|左下", (-1, -1)),
    (r"\bleft\b|\bwest(?:ern)?\b|westen|westlich\w*|\blinks\b|linke\w*|oeste|izquierd\w*|左|西", (-1, 0)),
    (r"\bright\b|\beast(?:ern)?\b|osten|östlich\w*|\brechts\b|rechte\w*|\beste\b|derech\w*|右|东", (1, 0)),
    (
        (
            r"\bnorth(?:ern)?\b|\btop\b|straight up|\bup\b|upwards|norden|nördlich\w*"
            r"|\boben\b|\bnorte\b|arriba|\+ ?y\b|上方|上侧|北"
        ),
        (0, 1),
    ),
    (r"\bsouth(?:ern)?\b|\bbottom\b|downwards?|süden|südlich\w*|\bunten\b|\bsur\b|abajo|- ?y\b|下方|下侧|南", (0, -1)),
]
"""Words of a direction → its signs along x and y."""

LAYOUTS: dict[str, str] = {
    "talking": (
        r"(?:talk|chat|convers|stand)\w*[^.]{0,40}(?:circle|ring|each other)|unterhalten sich"
        r"|conversa\w*|charla\w*|交谈|聊天"
    ),
    "wander": r"wander\w*|stroll\w*|new random destination|umher|spazieren|pasea\w*|闲逛|漫步|游荡",
    "crossing": (
        r"(?:cross|walk)\w* (?:in front of|the (?:way|path) of|before)|cross\w*[^.]{0,60}(?:right|left)"
        r"|quert?\w*|cruza\w*|横穿|横过"
    ),
    "both-ways": r"both (?:ways|directions)|beide\w* richtungen|ambos sentidos|双向|两个方向",
    "opposite": r"diametrically opposite|opposite (?:point|side)|antipod\w*|gegenüberliegend\w*|opuest\w*|对面",
    "random": r"\brandom\w*|zufällig\w*|aleatori\w*|al azar|随机",
    "perlin": r"perlin",
    "fog": r"\bfog\b|nebel|niebla|迷雾|uncover\w*|reveal\w*",
    "swap": r"pass(?:ing)? each other|head-on|meet|swap|einander|se cruzan|交会|相向",
    "crowd": r"crowd\w*|busy|dense|menschenmenge|multitud|abarrotad\w*|拥挤",
    "parked": r"parked|stationary|stands? still|does not move|geparkt\w*|stehend\w*|aparcad\w*|estacionad\w*|静止|停着",
    "walls": (
        r"(?:walls|boundary|fence)[^.]{0,25}(?:around|all sides|at the edge)|closed by walls"
        r"|enclosed|walled|umzäunt"
    ),
}
"""Arrangement → words."""

NOT_FLAT = (
    r"\baltitude|\bfly\w*\b|\bflight\b|\bdrones?\b|\bstairs?\b|\bstaircase|\bupstairs"
    r"|\belevators?\b|\bceiling|\bheights? of \d"
    r"|\bramps?\b|\bflughöhe|\bfliegen|\bdrohnen?\b|\btreppen?\b|\bescaleras?\b"
    r"|\bvolar\b|\bdron(?:es)?\b|无人机|飞行|楼梯"
)
"""Words of a third dimension, which a flat world lacks."""
UNKNOWN_REFERENCE = (
    r"\bthe usual\b|\bour (?:standard|usual|lab|office)\b|\bas (?:always|last time|before)\b"
    r"|wie immer|de siempre|老样子"
)
"""Words that point to something that only the user knows."""


def has(text: str, pattern: str) -> bool:
    """Whether a pattern occurs in a text."""
    return re.search(pattern, text) is not None


def first(text: str, table: dict[str, str]) -> str | None:
    """The name whose words come first in a text; the earlier name where two begin at one place."""
    matches = [
        (match.start(), i, name) for i, (name, words) in enumerate(table.items()) if (match := re.search(words, text))
    ]
    return min(matches)[2] if matches else None
