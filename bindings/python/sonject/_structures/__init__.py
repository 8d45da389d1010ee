"""The public structures of include/sonject, field by field and under their C names.

tests/test_declarations.py compares them with the headers and with the C compiler's layout.
"""

from ._capacities import *
from ._handles import *
from ._image import *
from ._object import *
from ._result import *
from ._sea import *
from ._sonar import *
from ._work import *
