"""The public names and where they are: the one list of them, for type checkers and, by `lazy_loader`, for imports."""

from .errors import RobotWarning as RobotWarning
from .errors import SpearError as SpearError
from .gaits.bounding import bounding as bounding
from .gaits.bounding_law import BoundingLaw as BoundingLaw
from .gaits.codesign.design import Design as Design
from .gaits.codesign.optimize_design import optimize_design as optimize_design
from .gaits.continuation.branch import Branch as Branch
from .gaits.continuation.continuing import continue_gait as continue_gait
from .gaits.gait import Gait as Gait
from .gaits.hopping import HoppingLaw as HoppingLaw
from .gaits.hopping import hopping as hopping
from .gaits.orbits.embedding import in_space as in_space
from .gaits.search import find_gait as find_gait
from .gaits.sensitivity.sensitivity import Sensitivity as Sensitivity
from .gaits.sensitivity.uncertainty import Uncertainty as Uncertainty
from .gaits.spatial.bounding import bounding_in_space as bounding_in_space
from .gaits.spatial.law import SpatialLaw as SpatialLaw
from .gaits.spatial.pronking import pronking as pronking
from .gaits.spatial.trot_law import TrotLaw as TrotLaw
from .gaits.spatial.trotting import pacing as pacing
from .gaits.spatial.trotting import trotting as trotting
from .hybrid.batch import simulate_many as simulate_many
from .hybrid.contact import Contact as Contact
from .hybrid.ground import Ground as Ground
from .hybrid.simulate import simulate as simulate
from .hybrid.trajectory import Trajectory as Trajectory
from .model.chain import from_chain as from_chain
from .model.chain import to_chain as to_chain
from .model.clutch import Clutch as Clutch
from .model.legs import Leg as Leg
from .model.loading import load as load
from .model.monopod import monopod as monopod
from .model.robot import Robot as Robot
from .model.sagittal import sagittal as sagittal
from .model.spring import Spring as Spring
from .model.variants import vary as vary
from .viz.compare.comparison import compare as compare

__version__: str
