#!/usr/bin/env python3
"""Mistakes in data sets: each is refused with exit status 2, in the words of its group and item, and no table is written;
what is only doubtful is said, and the run goes on. Cases that once did not end, or ended with NaN.

usage: mistakes.py BIN   (directory with the programs). The last line is N passed, N failed.
"""
import os
import resource
import subprocess
import sys
import tempfile

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "tools"))
from tally import check, report

TOP = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
BIN = os.path.abspath(sys.argv[1])

SKETCH = """A SKETCH
 &CHAIN JNT='A','B','C','D','P', JX=0.0,-4.0,33.0,90.0,20.0, JY=0.0,31.0,82.0,5.0,95.0,
  LNAME='frame','crank','coupler','rocker', LNK='A D','A B','B C P','C D' &END
 &DRIVES DRIVE='A' &END
 &OUTPUTS OUTPUT='point P' &END
 &METHOD NDES=2, DELT=0.0,5.0 &END
"""
BRACED = """A PARALLELOGRAM WITH A THIRD LINK
 &CHAIN JNT='A','B','C','D','E','F', JX=0.0,18.0,58.0,40.0,70.0,88.0, JY=0.0,24.0,24.0,0.0,10.0,34.0,
  LNK='A D E','A B','D C','E F','B C F', KOVER=1 &END
 &DRIVES DRIVE='A' &END
 &METHOD NDES=2, DELT=0.0,5.0 &END
"""
GEARS = """A GEARED FIVE-BAR
 &CHAIN JNT='A','B','C','D','E', JX=0.0,1.0,3.0,5.0,6.0, JY=0.0,2.0,4.0,2.0,0.0,
  LNAME='frame','one','two','three','four', LNK='A E','A B','B C','C D','D E',
  GEARA='one', GEARB='four', GCARR='frame', GTA=20.0, GTB=40.0 &END
 &DRIVES DRIVE='A' &END
 &OUTPUTS OUTPUT='point C' &END
 &METHOD NDES=2, DELT=0.0,5.0 &END
"""
SLIDER = """A SLIDER-CRANK
 &CHAIN JNT='A','B','C', JX=0.0,0.0,136.0, JY=0.0,40.0,10.0, LNAME='frame','crank','rod','piston', LNK='A','A B','B C','C',
  NSLIDE=1, SLNK='frame', SLNK2='piston', SLX=0.0, SLY=10.0, SLANG=0.0 &END
 &DRIVES DRIVE='A' &END
 &OUTPUTS OUTPUT='point C' &END
 &METHOD NDES=2, DELT=0.0,5.0 &END
"""
DRIVES = """TWO DRIVES
 &CHAIN JNT='A','B','C','D','E', JX=0.0,1.0,3.0,5.0,6.0, JY=0.0,2.0,4.0,2.0,0.0,
  LNAME='frame','one','two','three','four', LNK='A E','A B','B C','C D','D E' &END
 &DRIVES DRIVE='A','E', DELT2=0.0,5.0 &END
 &OUTPUTS OUTPUT='point C' &END
 &METHOD NDES=2, DELT=0.0,5.0 &END
"""
DYADS = """A FOUR-BAR AND THREE DYADS ON ITS COUPLER
 &CHAIN JNT='A','B','C','D','P','E','F','G','H','K','L', JX=0.0,-4.0,33.0,90.0,20.0,50.0,80.0,-10.0,-40.0,60.0,95.0,
  JY=0.0,31.0,82.0,5.0,95.0,130.0,90.0,130.0,90.0,150.0,110.0,
  LNK='A D F H L','A B','B C P','C D','P E','E F','P G','G H','P K','K L' &END
 &DRIVES DRIVE='A' &END
 &OUTPUTS OUTPUT='angle K L' &END
 &METHOD NDES=2, DELT=0.0,5.0, DESANG=1.0,2.0 &END
"""
CARRIED = """A GUIDE ON A LINK THAT SLIDES, FROM THE FOOT OF ITS SLIDE
 &LINKS NLOOP=3, MAXARC=6, ILINK=1,2,3,4,0,0, 1,-2,-3,-4,-4,0, 1,2,-3,4,5,-4,
  ILOOP=1,0,0,1,0,0, 1,1,-2,0,1,0, 2,2,2,-3,-6,1,
  ARCL=25.7,102.0,101.1,79.4,0,0, 0.0,27.5,0.0,133.5,117.3,0, 0.0,0.0,81.5,0.0,0.0,126.6,
  GAMA=0.0,0.0,0.0,178.9,0,0, 0.0,-31.7,0.0,0.0,143.0,0, 0.0,0.0,151.3,0.0,0.0,-153.5, NOUTLK=-5, NOUTLP=3 &END
 &METHOD MOTION=0, CRNKI=35.5, NDES=2, DELT=0.0,12.0 &END
"""
FOUR_BAR = """A FOUR-BAR
 &LINKS NLOOP=1, MAXARC=4, ILINK=1,-2,-3,4, ILOOP=1,0,0,1, ARCL=40.0,120.0,80.0,130.0, GAMA=3*0.0,180.0, NOUTLK=3, NOUTLP=1 &END
 &METHOD MOTION=1, IKIN=30 &END
 &LIMITS TANGLE=90.0 &END
"""
with open(os.path.join(TOP, "data", "path18.nml"), encoding="utf-8") as path_file:
    PATH_SEARCH = path_file.read()
PATH = "POINTS\n &EXACT XP=0.0,1.0,2.0,3.0, YP=0.0,0.5,0.4,0.1 &END\n"
POSES = "POSES\n &EXACT KIND='MOTION', XP=0.0,1.0,2.0,3.0,4.0, YP=0.0,0.5,0.4,0.1,0.0, ANGP=0.0,5.0,9.0,20.0,30.0 &END\n"
TABLE = "TABLE\n &EXACT KIND='FUNCTION', PHI=0.0,20.0,40.0,60.0,80.0, PSI=0.0,15.0,35.0,50.0,70.0 &END\n"
NAMED = "FUNCTION\n &EXACT KIND='FUNCTION', FUNC='POWER', FXLOW=1.0, FXHIGH=2.0, FPOWER=1.5, DPHI=60.0, DPSI=60.0 &END\n"

PUMP = """A CAM WITH A ROLLER ON A LEVER
 &CHAIN JNT='L','R','K','P', JX=0,60,100,100, JY=0,0,0,-60, LNAME='frame','lever','rod','piston',
  LNK='L','L R K','K P','P', SLNK='frame', SLNK2='piston', SLX=100, SLY=-60, SLANG=90 &END
 &DRIVES DRIVE='L' &END
 &OUTPUTS OUTPUT='slide S1' &END
 &METHOD NDES=1, DELT=0 &END
 &CAM NSEG=4, SEGEND=120,180,300,360, OUT0=-10, SEGOUT=10,10,-10,-10, LAW='MODSINE','DWELL','MODSINE','DWELL',
  FOLJNT='R', RROLL=10, XCAM=60, YCAM=-50, CAMRPM=200, CAMWID=0.01 &END
 &MASSES MNAME='piston', MASS=0.5, UNITL=0.001 &END
"""

# base, what is changed into what, what is said
MISTAKES = [
    # outputs
    (SKETCH, "'point P'", "'point P','point P'", "&OUTPUTS OUTPUT: output 'point P' is given twice"),
    (SKETCH, "'point P'", "'point P', ONAME='P'", "&OUTPUTS ONAME: output 'P' would have the columns of the joint of that name"),
    (SKETCH, "'point P'", "'point P',' '", "output 2 is empty"),
    (SKETCH, "'point P'", "'x P P'", "'x P P' names 2 joints; 1 are needed"),
    (SKETCH, "'point P'", "'point'", "names 0 joints; 1 are needed"),
    (SKETCH, "'point P'", "'between A B D'", "names 3 joints; 4 are needed"),
    (SKETCH, "'point P'", "'between coupler rockr'", "no link is called 'rockr'; did you mean 'rocker'?"),
    (SKETCH, "'point P'", "'pose P'", "'pose P rocker' names a joint and a link"),
    (SKETCH, "'point P'", "'ratio one two'", "no output given before is called 'one'"),
    (SKETCH, "'point P'", "'ratio one'", "'ratio wheel shock' names two outputs given before"),
    (SKETCH, "'point P'", "'point P','angle B C','ratio point_P angle_B_C'", "output 'point_P' is not one number whose rate has a ratio"),
    (SKETCH, "'point P'", "'P'", "'P' is no output; there are point, x, y, angle, distance, slide, between, pose, ratio: 'point P'"),
    (SKETCH, "'point P'", "'rocker'", ": 'angle rocker'"),
    (SLIDER, "'point C'", "'slide'", "'slide S1' names one slide"),
    (SLIDER, "'point C'", "'slide S2'", "no slide is called 'S2'"),
    (SLIDER, "'point C'", "'angle piston'", "link piston has fewer than two joints and so no direction"),
    (SKETCH, "OUTPUT='point P'", "", "says what is wanted"),
    # gears
    (GEARS, "GEARB='four', ", "", "&CHAIN GEARB: names the second wheel of 0 gear pairs; GEARA names 1"),
    (GEARS, "GCARR='frame', ", "", "&CHAIN GCARR: names the carrier of 0 gear pairs; GEARA names 1"),
    (GEARS, ", GTB=40.0", "", "gear pair 1 needs the teeth of both wheels, GTA and GTB"),
    (GEARS, "GEARB='four'", "GEARB='one'", "a gear pair has three different links"),
    (GEARS, "GEARB='four'", "GEARB='three'", "link frame carries wheel three, but no joint pins them together"),
    # what varies
    (SKETCH, "'C D' &END", "'C D', VARY='A B',' ' &END", "value 2 is empty"),
    (SKETCH, "'C D' &END", "'C D', VARY='A' &END", "'A' names 1 joint, not 2; there are 'A B', 'angle A B A C', 'place D', 'input'"),
    (SKETCH, "'C D' &END", "'C D', VARY='place P' &END", "'place P': the joint is not on the frame"),
    (SKETCH, "'C D' &END", "'C D', VARY='A C' &END", "'A C': no link has all these joints"),
    (DYADS, " &METHOD", " &TOLER TOLNAM='C P', TOLVAL=0.1 &END\n &METHOD", "the length C P is no dimension of the loops; there are the lengths A B, B C, C D, D A, B P, P E, E F, F A, "
     "P G, G H, H A, P K and 2 more, and the angles between them"),
    (SKETCH, "'C D' &END", "'C D', VARY='A B', VLOW=2.0, VHIGH=1.0 &END", "the lower bound of 'A B' is above its upper bound"),
    (SKETCH, "'C D' &END", "'C D', VARY='place D', VLOW=2.0, VHIGH=3.0 &END", "2 values each (a place has two, x and y); found 1 and 1"),
    # slides
    (SLIDER, "NSLIDE=1", "NSLIDE=0", "&CHAIN SLNK: names links of slides, but NSLIDE=0"),
    (SLIDER, "NSLIDE=1", "NSLIDE=2", "&CHAIN SLNK: names the first link of 1 slides; there are 2"),
    (SLIDER, "NSLIDE=1", "NSLIDE=2", "&CHAIN SLNK2: names the second link of 1 slides; there are 2"),
    (SLIDER, ", SLANG=0.0", "", "&CHAIN SLANG: is given for 0 slides; there are 1"),
    (SLIDER, "NSLIDE=1", "NSLIDE=1, SNAME='A'", "both a joint and a slide are called A"),
    (SLIDER, "SLNK2='piston'", "SLNK2='frame'", "slide S1 has link frame on both sides; name the link that it moves on"),
    # drives
    (DRIVES, ", DELT2=0.0,5.0", "", "&DRIVES DELT2: drive E needs its values, DELT2, or a RATIO to the first drive"),
    (DRIVES, "DELT2=0.0,5.0", "DELT2=0.0,5.0, RATIO=0.0,2.0", "drive E has RATIO too; give one of both"),
    (DRIVES, "DELT2=0.0,5.0", "DELT2=0.0,5.0, PHASE=10.0", "drive A has no RATIO; PHASE is added to RATIO times the first drive"),
    (DRIVES, "DELT2=0.0,5.0", "DELT2=0.0,5.0, PHASE=0.0,10.0", "drive E has no RATIO; PHASE is added"),
    (DRIVES, "DELT2=0.0,5.0", "DELT2=0.0,5.0, NGRID=3,3, DLOW=0.0,0.0, DHIGH=5.0,5.0", "the grid NGRID gives the positions of all drives"),
    (DRIVES, "DELT2=0.0,5.0", "RATIO=0.0,2.0, NGRID=3,3, DLOW=0.0,0.0, DHIGH=5.0,5.0", "drive E follows the first by its RATIO; its NGRID is 0"),
    (DRIVES, "DELT2=0.0,5.0", "DELT2=0.0,5.0, DSPEED=1.0,0.0", "the first drive has the speed of &RATES; its entry here is 0"),
    (DRIVES, "DELT2=0.0,5.0", "RATIO=0.0,2.0, DSPEED=0.0,1.0", "drive E follows the first by its RATIO; its entry here is 0"),
    (SKETCH, "DRIVE='A'", "DRIVE='A', DBASE='rocker'", "&DRIVES DBASE: link rocker is not at joint A; the links there are frame and crank"),
    (SKETCH, "DRIVE='A'", "DRIVE='A', DLINK='rocker'", "&DRIVES DLINK: link rocker is not at joint A; the links there are frame and crank"),
    (SKETCH, "DRIVE='A'", "DRIVE='A', DBASE='coupler', DLINK='rocker'", "link coupler is not at joint A; the links there are frame and crank"),
    (SKETCH, "DRIVE='A'", "DRIVE='A', DBASE='crank', DLINK='crank'", "drive A has link crank on both sides; it moves DLINK against DBASE"),
    (SLIDER, "DRIVE='A'", "DRIVE='S1', DLINK='rod'", "link rod is not at slide S1; the links there are frame and piston"),
    (SKETCH, "DRIVE='A'", "DRIVE='crank'", "'crank' is a link; a link is driven at a joint, here DRIVE='A'"),
    (SLIDER, "DRIVE='A'", "DRIVE='piston'", "'piston' is a link; a link is driven at a slide, here DRIVE='S1'"),
    (SKETCH, "DRIVE='A'", "DRIVE='coupler'", "'coupler' is a link; name the joint or slide that moves it"),
    # counts of names: what may be missing
    (SKETCH, "'A D',", "", "names 4 links, but LNK lists 3; each name needs an entry of LNK with the link's joints, the frame (frame) first: "
     "are the joints of one link missing there?"),
    (SKETCH, "'C D' &END", "'C D','P D' &END", "names 4 links, but LNK lists 5; the link of joints 'P D' has no name: name it, or leave it out "
     "if the others hold the linkage without it"),
    # desired values that the first output cannot have
    (SKETCH, "OUTPUT='point P' &END\n &METHOD NDES=2, DELT=0.0,5.0", "OUTPUT='x P' &END\n &METHOD NDES=2, DELT=0.0,5.0, DESX=2*1.0, "
     "DESY=2*1.0", "the desired values of &METHOD are those of the first output, which x_P cannot be here; give its values as DES1 of &OUTPUTS, "
     "or put a point, angle, distance from the origin or slide first"),
    # solvers
    (FOUR_BAR, " &LIMITS", " &SEARCH SOLVER='LEASTSQ' &END\n &LIMITS", "no solver is called 'LEASTSQ'"),
    (FOUR_BAR, " &LIMITS", " &SEARCH SOLVER='LEASTSQ' &END\n &LIMITS", "usual ones are LSQ, SIMPLEX, LD_SLSQP and LN_COBYLA; the manual lists all 4"),
    # no data set at all
    (SKETCH, SKETCH, 'joints: A 0 0\n', "no group is in the case that begins here; a case is a title line, then groups, each as "
     "&METHOD IKIN=10 &END: a sketch (&CHAIN, &DRIVES, &OUTPUTS) or loops (&LINKS), and &METHOD"),
    (SKETCH, SKETCH, '{"joints": {"A": [0, 0]}}\n', "unknown group &JOINTS; did you mean &LINKS, or &CHAIN of a sketch?"),
    (FOUR_BAR, FOUR_BAR[FOUR_BAR.index(" &LINKS"):FOUR_BAR.index(" &METHOD")], "", "the group is missing in the case that begins here; a linkage "
     "is described by a sketch (&CHAIN) or by its loops (&LINKS)"),
    (SKETCH, "DRIVE='A'", "DRIVE='A', DBASE='crank', DLINK='crank'", "drive A has link crank on both sides"),
    (SKETCH, "DRIVE='A'", "DRIVE='A C P'", "'A C P' is no drive: a joint, a slide, or the two joints of a cylinder"),
    (SKETCH, "DRIVE='A'", "DRIVE='B C'", "cylinder 'B C' lies between two joints of link coupler, which holds them apart"),
    # the limit of the transmission angle
    (FOUR_BAR, "TANGLE=90.0", "TANGLE=90.0, TRMIN=40.0", "limit the same angle; leave one of them out"),
    (FOUR_BAR, "TANGLE=90.0", "TRMIN=90.0", "&LIMITS TRMIN: is the least transmission angle: at least 0, less than 90 degrees"),
    (FOUR_BAR, "TANGLE=90.0", "TRMIN=-1.0", "&LIMITS TRMIN: is the least transmission angle"),
    (FOUR_BAR, " &LIMITS TANGLE=90.0", " &CONSTR TRMIN=40.0 &END\n &LIMITS TRMIN=40.0", "&CONSTR TRMIN: is given in &LIMITS too"),
    (BRACED, " &METHOD", " &LIMITS TRMIN=40.0 &END\n &METHOD", "have no transmission angle"),
    (BRACED, " &METHOD", " &SWEEP SWJNT='angle B C B F', SWLOW=1.0, SWHIGH=2.0 &END\n &METHOD", "meet with the lengths they have and no others"),
    (BRACED, " &METHOD", " &SWEEP SWJNT='A B', SWLOW=29.0, SWHIGH=31.0 &END\n &METHOD", "meet with the lengths they have and no others"),
    (BRACED, " &METHOD", " &CONSTR TRMIN=40.0 &END\n &METHOD", "&CONSTR TRMIN"),
    # desired values of outputs
    (SKETCH, "OUTPUT='point P'", "OUTPUT='point P', DES1=1.0,2.0,3.0", "NDES=2 positions of output point_P have 4 values, but only 3 given"),
    (SKETCH, "OUTPUT='point P'", "OUTPUT='point P', DES1=4*1.0, WGT1=-1.0", "weights must not be negative"),
    (SKETCH.replace("NDES=2, DELT=0.0,5.0", "NDES=3, DELT=0.0,5.0,9.0"), "OUTPUT='point P'", "OUTPUT='point P', DES1=6*1.0, WGT1=1.0,2.0",
     "is one weight, or one for each of NDES=3 positions; found 2"),
    (SKETCH, "OUTPUT='point P'", "OUTPUT='angle B C','angle C D','ratio angle_B_C angle_C_D', DVEL3=1.0,2.0",
     "output ratio_angle_B_C_angle_C_D is a ratio of rates; of that no derivative can be prescribed"),
    # tolerances in searches
    (PATH_SEARCH, " &SEARCH", " &TOLER TOLLEN=0.005, TOLOBJ=-1.0 &END\n &SEARCH", "TOLOBJ: must not be negative"),
    (PATH_SEARCH, " &SEARCH SOLVER='LSQ', NSTART=200, NBEST=3", " &TOLER TOLLEN=0.005, TOLOBJ=1.0 &END\n &SEARCH SOLVER='SIMPLEX'",
     "TOLOBJ: is for searches by other solvers than SOLVER='SIMPLEX'"),
    (PATH_SEARCH, " &SEARCH", " &TOLER TOLOBJ=1.0 &END\n &SEARCH", "TOLOBJ: no dimension has a tolerance above 0"),
    (PATH_SEARCH, "NBEST=3", "NBEST=3, NEARLY=1.1", "&SEARCH NEARLY: how sensitive a linkage is, is its band by &TOLER"),
    (PATH_SEARCH, "NBEST=3", "NBEST=3, NEARLY=1.1, PARETO='BAND'", "NEARLY: PARETO ranks by the objective; give one of them"),
    (PATH_SEARCH, "NBEST=3", "NEARLY=1.1", "NEARLY: linkages to choose from are wanted; give NBEST"),
    (PATH_SEARCH, "NBEST=3", "NEARLY=0.9, NBEST=2", "NEARLY: must be at least 1"),
    # cheapest tolerances
    (FOUR_BAR, " &LIMITS", " &ALLOC ALRULE='RSS' &END\n &LIMITS", "&ALLOC ALBAND: missing; this item is required"),
    (FOUR_BAR, " &LIMITS", " &ALLOC ALBAND=0.0 &END\n &LIMITS", "&ALLOC ALBAND: entry 1: must be above 0"),
    (FOUR_BAR, " &LIMITS", " &ALLOC ALBAND=0.1, ALYLD=99.0 &END\n &LIMITS", "ALYLD: is for ALRULE='YIELD'"),
    (FOUR_BAR, " &LIMITS", " &ALLOC ALBAND=0.1, ALLAW='NORMAL' &END\n &LIMITS", "ALLAW: is for ALRULE='YIELD' and for a sample"),
    (FOUR_BAR, " &LIMITS", " &ALLOC ALBAND=0.1, ALRULE='RSS', ALPROF='CHECK' &END\n &LIMITS", "ALPROF: is for ALRULE='WORST'"),
    (FOUR_BAR, " &LIMITS", " &ALLOC ALBAND=0.1, ALPROF='MAYBE' &END\n &LIMITS", "one of 'NO', 'CHECK', 'SCALE'"),
    (FOUR_BAR, " &LIMITS", " &ALLOC ALBAND=0.1, ALNAM='length A B' &END\n &LIMITS",
     "no dimension with a tolerance is called 'length A B'; there are 'length of arc 1 in loop 1'"),
    (FOUR_BAR, " &LIMITS", " &ALLOC ALBAND=0.1, ALNAM='*', ALMIN=0.2, ALMAX=0.1 &END\n &LIMITS", "the least tolerance of * is above the largest"),
    (FOUR_BAR, " &LIMITS", " &ALLOC ALBAND=0.1, ALOUT='P.x' &END\n &LIMITS", "no number of an output is called 'P.x'; there are"),
    (FOUR_BAR, " &LIMITS", " &ALLOC ALBAND=0.1, ALPOS=1.0,2.0 &END\n &LIMITS", "positions is expected; found 2"),
    (FOUR_BAR, " &LIMITS", " &TOLER TOLLEN=0.0 &END\n &ALLOC ALBAND=0.1 &END\n &LIMITS", "no dimension has a tolerance that is above 0"),
    (SKETCH, " &METHOD", " &ALLOC ALBAND=0.1, ALNAM='A B','B C', ALMIN=0.2,0.0, ALMAX=0.3,0.1, ALCLAS=1,1 &END\n &METHOD",
     "class 1: the least tolerance of one dimension is above the largest of another"),
    (SKETCH, " &METHOD", " &ALLOC ALBAND=0.1,0.2,0.3 &END\n &METHOD", "&ALLOC ALBAND: too many values"),
    (SKETCH, " &METHOD", " &ALLOC ALBAND=0.1, ALNAM='A B', ALGRAD=3 &END\n &METHOD", "&ALLOC ALGRAD: grades are 5 to 13; found 3"),
    (SKETCH, " &METHOD", " &ALLOC ALBAND=0.1, ALNAM='A B', ALGRAD=9, ALGRDC=7 &END\n &METHOD", "the coarsest grade of A B is finer"),
    (SKETCH, " &METHOD", " &ALLOC ALBAND=0.1, ALNAM='A B', ALGRAD=9, ALTAB=1, ALSTEP=0.1, ALSCST=1.0 &END\n &METHOD",
     "A B has grades (ALGRAD) and cannot have a table, too"),
    (SKETCH, " &METHOD", " &ALLOC ALBAND=0.1, ALNAM='A B', ALTAB=2, ALSTEP=0.1, ALSCST=1.0 &END\n &METHOD", "table 2 has no steps"),
    (SKETCH, " &METHOD", " &ALLOC ALBAND=0.1, ALNAM='A B', ALTAB=1, ALSTEP=0.1,0.2, ALSCST=1.0 &END\n &METHOD",
     "a cost for each of the 2 steps of ALSTEP is expected; found 1"),
    (SKETCH, " &METHOD", " &ALLOC ALBAND=0.1, ALNAM='A B', ALSTEP=0.1,0.2, ALSCST=1.0,0.5 &END\n &METHOD", "no dimension has these steps"),
    (SKETCH, " &METHOD", " &ALLOC ALBAND=0.1, ALNAM='A B', ALGRAD=6, ALGCST=3.0,2.0 &END\n &METHOD", "IT5 to IT13 are expected; found 2"),
    (SKETCH, " &METHOD", " &ALLOC ALBAND=0.1, ALUNIT=25.4 &END\n &METHOD", "&ALLOC ALUNIT: no dimension has grades"),
    (SKETCH, " &METHOD", " &ALLOC ALBAND=0.1, ALNODE=10 &END\n &METHOD", "no dimension has grades or steps"),
    (SKETCH, " &METHOD", " &TOLER TOLLEN=0.1, TOLANG=0.1 &END\n &ALLOC ALBAND=0.1, ALNAM='*', ALGRAD=6 &END\n &METHOD",
     "'*' means angles, and ISO 286 has grades for lengths"),
    (SKETCH, " &METHOD", " &ALLOC ALBAND=0.1, ALNAM='A B','B C', ALGRAD=6,0, ALCLAS=1,1 &END\n &METHOD",
     "class 1 has grades, steps of a table and tolerances of any size, or two of these"),
    (SKETCH, " &METHOD", " &ALLOC ALBAND=0.1, ALCORR=0.5 &END\n &METHOD", "no dimension is in a correlated group (ALGRP)"),
    (SKETCH, " &METHOD", " &ALLOC ALBAND=0.1, ALNAM='A B', ALGRP=1, ALCORR=1.5 &END\n &METHOD", "&ALLOC ALCORR: entry 1: must be"),
    (SKETCH, " &METHOD", " &ALLOC ALBAND=0.1, ALNAM='A B', ALGRP=1, ALPROF='CHECK' &END\n &METHOD", "as if no deviations were correlated"),
    (SKETCH, " &METHOD", " &ALLOC ALBAND=0.1, ALNAM='A B', ALGRAD=6, ALPROF='SCALE' &END\n &METHOD", "grades and steps (ALGRAD, ALTAB) are what"),
    (BRACED, " &METHOD", " &ALLOC ALBAND=0.1 &END\n &METHOD", "meet with the lengths they have and no others"),
    # sweeps
    (FOUR_BAR, " &LIMITS", " &SWEEP SWHAT='WIDTH', SWLOW=1.0, SWHIGH=2.0 &END\n &LIMITS", "one of 'LENGTH', 'ANGLE', 'OUTLK'"),
    (FOUR_BAR, " &LIMITS", " &SWEEP SWLINK=9, SWLOOP=1, SWLOW=1.0, SWHIGH=2.0 &END\n &LIMITS", "there is no arc 9"),
    (FOUR_BAR, " &LIMITS", " &SWEEP SWLINK=2, SWLOOP=1, SWLOW=-1.0, SWHIGH=2.0 &END\n &LIMITS", "a length must be above 0"),
    (FOUR_BAR.replace("MAXARC=4, ILINK=1,-2,-3,4, ILOOP=1,0,0,1", "MAXARC=5, ILINK=1,-2,-3,4,0, ILOOP=1,0,0,1,0"), " &LIMITS",
     " &SWEEP SWLINK=5, SWLOOP=1, SWLOW=1.0, SWHIGH=2.0 &END\n &LIMITS", "loop 1 has no arc 5"),
    (SKETCH, " &METHOD", " &SWEEP SWLOW=1.0, SWHIGH=2.0 &END\n &METHOD", "the joints of the length or angle are expected, SWJNT='A B'"),
    (SKETCH, " &METHOD", " &SWEEP SWJNT='A', SWLOW=1.0, SWHIGH=2.0 &END\n &METHOD", "'A' names 1 joint, not 2; there are 'A B' and 'angle A B A C'"),
    # exact synthesis
    (PATH, "YP=0.0,0.5,0.4,0.1", "YP=0.0,0.5,0.4", "XP has 4 values, but YP has 3"),
    (PATH, "YP=0.0,0.5,0.4,0.1", "YP=0.0,,0.4,0.1", "&EXACT YP: point 2 has no value"),
    (PATH, "XP=", "PIVOTS=1.0, XP=", "is x and y of the crank's fixed pivot, then of the follower's"),
    (PATH, "XP=", "ANGP=5*0.0, XP=", "XP has 4 values only"),
    (PATH, "XP=", "ANGP=,1.0, XP=", "orientations are counted from that of the first point, which is missing"),
    (PATH, "XP=", "TIMP=,1.0, XP=", "crank angles are counted from that of the first point, which is missing"),
    (PATH, "XP=", "TIMP=0.0,1.0, ANGP=0.0,1.0, XP=", "point 2 has an orientation and a crank angle; one of both is possible"),
    (POSES, "30.0 &END", ", &END", "KIND='MOTION' needs an orientation for every point; point 5 has none"),
    (POSES, "30.0 &END", "30.0, ARM=0.0,1.0,2.0,3.0 &END", "is x and y of three joints in the first pose"),
    (TABLE, "PHI=0.0,20.0,40.0,60.0,80.0, ", "", "KIND='FUNCTION' needs either FUNC, a name, or PHI and PSI, a table"),
    (TABLE, "PHI=0.0,20.0,40.0,60.0,80.0", "PHI=0.0,20.0,40.0,60.0", "PHI has 4 values, but PSI has 5"),
    (TABLE, "PHI=0.0,20.0,40.0,60.0,80.0", "PHI=0.0,,40.0,60.0,80.0", "a value of the table is missing"),
    (TABLE, "PHI=0.0,20.0,40.0,60.0,80.0", "PHI=0.0,20.0,10.0,60.0,80.0", "entry 3: the inputs must rise"),
    (TABLE, "80.0, PSI=0.0", "80.0,90.0, PSI=-9.0,0.0", "6 points cannot be met exactly; give 3 or 5, or MINIMAX=1"),
    (TABLE, "80.0, PSI=0.0,15.0,35.0,50.0,70.0", "80.0, PSI=0.0,15.0,35.0,50.0,70.0, SIXBAR='WATT', SLIDER=1", "a six-bar here has no slider"),
    (TABLE, ",80.0, PSI=0.0,15.0,35.0,50.0,70.0", ", PSI=0.0,15.0,35.0,50.0, SIXBAR='WATT'", "5 points (a sample), 8 with ARMLEN or 9"),
    (TABLE, ",80.0, PSI=0.0,15.0,35.0,50.0,70.0", ", PSI=0.0,15.0,35.0,50.0, MINIMAX=1", "needs FUNC or a table of more than 5 points"),
    (TABLE, ",80.0, PSI=0.0,15.0,35.0,50.0,70.0", ", PSI=0.0,15.0,35.0,50.0, SLIDER=1, PSI0=3.0", "four points of a slider-crank need the zero line"),
    (TABLE, ",60.0,80.0, PSI=0.0,15.0,35.0,50.0,70.0", ", PSI=0.0,15.0,35.0, PHI0=1.0, PSI0=2.0, SLIDER=1", "three points with zero lines are for four-bars"),
    (TABLE, "KIND=", "CRANK=1.0,2.0, KIND=", "&EXACT CRANK: is for six-bars"),
    (TABLE, "KIND=", "SIXBAR='WATT', NPOINT=9, KIND=", "&EXACT NPOINT: is for FUNC; a table has its own points"),
    (NAMED, "KIND=", "SIXBAR='WATT', NPOINT=8, KIND=", "5 points (a sample), 8 with ARMLEN or 9"),
    (NAMED, "KIND=", "SIXBAR='WATT', NPOINT=9, CRANK=0.3,0.1, KIND=", "is not to be chosen in a six-bar of Watt II"),
    (NAMED, "KIND=", "SIXBAR='WATT', NPOINT=9, NGRID=4, KIND=", "through more all are found"),
    (NAMED, "KIND=", "SIXBAR='STEPHENSON', NPOINT=8, KIND=", "or, with PIVOTS and CRANK, 7"),
    (NAMED, "KIND=", "SIXBAR='WATT', NPOINT=8, ARMLEN=1.0, KIND=", "is the length of the frame: kites and parallelograms"),
    (NAMED, "KIND=", "SIXBAR='STEPHENSON2', NPOINT=8, ARMLEN=1.2, KIND=", "made for 8 points with OUTPIN and ARMLEN"),
    (NAMED, "KIND=", "SIXBAR='STEPHENSON2', NPOINT=11, KIND=", "START=1 asks for them"),
    (NAMED, "KIND=", "ARMLEN=1.2, KIND=", "is for six-bars: SIXBAR='WATT'"),
    (NAMED, "KIND=", "SIXBAR='STEPHENSON', NPOINT=7, PIVOTS=1.5,0.5, KIND=", "need the third fixed pivot, PIVOTS=x,y, and the crank"),
    (NAMED, "KIND=", "SIXBAR='STEPHENSON', NPOINT=7, PIVOTS=1.5,0.5, CRANK=0.6,0.8, KIND=", "is as long as the frame: kites and parallelograms"),
    (NAMED.replace("FPOWER=1.5", "FPOWER=1.0"), "KIND=", "SIXBAR='WATT', NPOINT=9, KIND=", "the output turns as the input does"),
    (NAMED.replace("DPHI=60.0", "DPHI=7200.0"), "KIND=", "SIXBAR='WATT', CRANK=0.3,0.1, KIND=", "of a six-bar through five points is sampled"),
    (NAMED, "'POWER'", "'POWR'", "there is no function 'POWR'; there are LOG10, LN, EXP, SIN, COS, TAN, POWER"),
    (NAMED, "FXHIGH=2.0", "FXHIGH=1.0", "the range of x is empty: FXHIGH must be above FXLOW"),
    (NAMED, "FXLOW=1.0", "FXLOW=-1.0", "this power needs x above 0"),
    (NAMED, "DPSI=60.0", "DPSI=0.0", "&EXACT DPSI: must not be 0"),
]

FLEX = """ &RATES SPEED=90.0 &END
 &FLEX XNAME='coupler B','rocker C', YNAME='coupler C','rocker D', XMOD=207E9, XRHO=7850.0, XDEPTH=0.020, XAREA=5E-5, XGYR=5.774E-3 &END
"""
# the same by another program
REFUSED = [
    # numbers whose squares have none, and counts beyond all memory (found by random input)
    ("psalm", SKETCH, "DELT=0.0,5.0", "DELT=0.0,5.0, DESX=1.0,1E300, DESY=1.0,2.0", "DESX: is implausibly large"),
    ("kalm", SKETCH, "&METHOD", "&MASSES MNAME='rocker', MASS=1.0, UNITL=1E300 &END\n &METHOD", "UNITL: metres in one unit of length: must be above 0, from 1e-30"),
    ("kalm", SKETCH, "&METHOD", "&RATES SPEED=4.9E-324 &END\n &METHOD", "SPEED: is so small that its square is lost"),
    ("kalm", SKETCH, "&METHOD", "&MASSES MNAME='rocker', MASS=1.0 &END\n &TIME TEND=8.0, NTIME=2147483647 &END\n &METHOD", "NTIME"),
    ("ssics", SKETCH, SKETCH[SKETCH.index("\n"):], "\n &HILL HC0=1.0 &END\n &DRIVEL DMEAN=10.0, DSPLOW=20.0, DSPHGH=120.0 &END\n &RATES &END\n",
     "need a linkage"),
    ("ssics", SKETCH, SKETCH[SKETCH.index("\n"):], "\n &HILL &END\n", "HC0: missing; the tables have no values"),
    ("ssics", SKETCH, " &METHOD", FLEX.replace("0.020", "0.020,1E300") + " &METHOD", "XDEPTH: the depth is more than 1000 times the radius of gyration"),
    ("ssics", SKETCH, " &METHOD", FLEX.replace("0.020", "0.011") + " &METHOD", "XDEPTH: no section of this depth has that radius of gyration"),
    ("kalm", CARRIED, " &METHOD", " &MASSES NMASS=1, MLINK=-2, MLOOP=1, MASS=1.0, UNITL=0.001 &END\n &METHOD",
     "&LINKS ILINK: joint S3 of loop 3 is no point of both links that it joins"),
]

# program, base, what is changed into what, what is said; the run goes on
DOUBTS = [
    ("psalm", SKETCH, "LNK='A D','A B','B C P','C D'", "LNK='A B','B C P','C D','A D'",
     "drive A turns link rocker against frame, not the link called crank: is the frame the first link of LNK?"),
    ("psalm", SKETCH, "NDES=2, DELT=0.0,5.0", "CRNKI=112.0, NDES=2, DELT=112.0,142.0",
     "&METHOD CRNKI: counts from the drawing in a sketch, and DELT from there: the first position is 224.0 from the drawing"),
    ("psalm", SKETCH, "'point P'", "'y C','point P'", "  Output              y_C 80.75798 to 82.0 at the positions"),
    ("psalm", SKETCH, "'point P'", "'point P','y C'", "  Output              y_C 80.75798 to 82.0 at the positions"),
    ("psalm", SKETCH, "'point P'", "'x P'", "  Inputs              count from the drawing, where the crank is at 97.35238 degrees from the x axis"),
    ("kalm", SKETCH, " &METHOD", " &RATES SPEED=1.0 &END\n &MASSES NMASS=1, MNAME='crank', MASS=1.0 &END\n &METHOD",
     "&MASSES UNITL: missing: lengths are taken as metres, and this linkage is 95 m large"),
    ("kalm", SKETCH.replace("JX=0.0,-4.0,33.0,90.0,20.0, JY=0.0,31.0,82.0,5.0,95.0", "JX=0.0,-4E10,33E10,90E10,20E10, JY=0.0,31E10,82E10,5E10,95E10"),
     " &METHOD", " &RATES SPEED=1.0 &END\n &MASSES MNAME='crank', MASS=1.0 &END\n &METHOD", "and this linkage is 950.0000E+09 m large"),
    ("kalm", SKETCH, " &METHOD", " &RATES SPEED=1.0 &END\n &LOADS LNAME='crank', LFX=1.0 &END\n &METHOD",
     "&MASSES UNITL: missing: lengths are taken as metres, and this linkage is 95 m large"),
    ("kalm", DRIVES, " &METHOD", " &RATES SPEED=1.0 &END\n &METHOD",
     "drive E stands still in the velocities and forces: its DSPEED of &DRIVES is 0, though DELT2 changes"),
    ("kalm", SKETCH, " &METHOD", " &MASSES MNAME='crank', MASS=1.0, UNITL=0.001 &END\n &METHOD", "there is no group &RATES: the input is taken to move at"),
    # items that nothing reads
    ("psalm", SKETCH, "DELT=0.0,5.0", "DELT=0.0,5.0, NITER=100, VAR=0.2",
     "&METHOD NITER: has no effect (nor VAR): it is for a search, but no dimension may vary"),
    ("psalm", SKETCH, " &METHOD", " &SEARCH SOLVER='LSQ', NSTART=5, THREADS=1 &END\n &METHOD",
     "&SEARCH SOLVER: has no effect (nor NSTART): it is for a search, but no dimension may vary"),
    ("psalm", FOUR_BAR, "IKIN=30", "IKIN=30, SNAKE=0.2, ISTART=7", "&METHOD SNAKE: has no effect: it is for a search, but IKIN asks for an analysis"),
    ("psalm", FOUR_BAR, "MOTION=1, IKIN=30 &END", "MOTION=1, IVA=1, NDES=1, DELT=0.0, DESANG=20.0, NCHECK=2 &END\n &SEARCH SOLVER='LSQ' &END",
     "&METHOD NCHECK: has no effect: it is for SOLVER='SIMPLEX', which this search does not have"),
    ("psalm", SKETCH, "DELT=0.0,5.0", "DELT=0.0,5.0, XMULT=2.0,1.0", "&METHOD XMULT: has no effect: there are no desired values"),
    ("psalm", SKETCH, "DELT=0.0,5.0", "DELT=0.0,5.0, DESX=20.0,21.0, DESY=95.0,96.0, DESANG=1.0,2.0",
     "&METHOD DESANG: has no effect: the output is a point, whose desired values are DESX and DESY"),
    ("psalm", FOUR_BAR, "IKIN=30", "IKIN=30, NDES=2, DELT=0.0,5.0", "&METHOD NDES: has no effect (nor DELT): IKIN asks for an analysis through one turn"),
    ("psalm", FOUR_BAR, "IKIN=30 &END", "IKIN=30 &END\n &SEARCH ORDER=1 &END", "&SEARCH ORDER: has no effect: it is for free timing"),
]
# the same without reason
SILENT = [
    ("psalm", SKETCH, "NDES=2, DELT=0.0,5.0", "CRNKI=5.0, NDES=2, DELT=0.0,30.0", "CRNKI"),
    ("psalm", SKETCH, "'point P'", "'y C','point P'", "Output point"),
    ("psalm", SKETCH, "'point P'", "'x C','y C','point P'", "joint P"),
    ("kalm", SKETCH, " &METHOD", " &RATES SPEED=1.0 &END\n &MASSES NMASS=1, MNAME='crank', MASS=1.0, UNITL=0.001 &END\n &METHOD", "UNITL"),
    ("kalm", DRIVES, "DELT2=0.0,5.0", "DELT2=0.0,5.0, DSPEED=0.0,2.0", "stands still"),
    ("kalm", DRIVES, "DELT2=0.0,5.0", "DELT2=5.0,5.0", "stands still"),
    ("psalm", SKETCH, " &METHOD", " &SEARCH THREADS=1, MAXTIME=9.0 &END\n &METHOD", "no effect"),
    ("calm", PUMP, "CAMRPM=200", "CAMRPM=300", "&RATES"),
    ("kalm", FOUR_BAR, "IKIN=30", "IKIN=30, SNAKE=0.2", "no effect"),
    ("psalm", FOUR_BAR, "MOTION=1, IKIN=30", "MOTION=1, IVA=1, NDES=1, DELT=0.0, DESANG=20.0, ANMULT=2.0, SNAKE=0.2, VAR=0.2", "no effect"),
]


UMBRELLA = """UMBRELLA, ONE RIB
 &CHAIN JNT='T','R','S','U','V','P','Q', JX=0.0,0.0,150000000.0,130.0,300.0,320.0,450.0, JY=600.0,350.0,560.0,530.0,480.0,510.0,420.0,
  LNAME='pole','runner','stretcher','rib','pull','outer', LNK='T','R','R U','T S U P','S V','P V Q',
  SLNK='pole', SLNK2='runner', SLX=0.0, SLY=350.0, SLANG=90.0 &END
 &DRIVES DRIVE='S1' &END
 &METHOD NDES=2, DELT=0.0,22.5 &END
"""
THIN = """FOUR-BAR, A COUPLER THAT BUCKLES
 &LINKS NLOOP=1, MAXARC=4, ILINK=1,2,3,4, ILOOP=1,0,0,1, ARCL=0.06,0.30,0.14,0.32, GAMA=3*0.0,180.0, NOUTLK=3, NOUTLP=1 &END
 &METHOD MOTION=1, IKIN=15 &END
 &RATES SPEED=80.0 &END
 &MASSES MLINK=3, MLOOP=1, MASS=0.7, MDIST=0.06, MANG=180.0, MINERT=2E-3 &END
 &VIBR VLINK=2, VLOOP=1, VMOD=207E9, VRHO=7850.0, VDEPTH=1E-150, VWIDTH=0.008, VZETA=0.02, NMODE=3 &END
"""
MASSLESS = """MOTOR
 &CHAIN JNT='A','B','C', JX=0.0,0.04,0.18, JY=0.0,0.0,0.01, LNAME='frame','crank','rod','piston', LNK='A','A B','B C','C',
  SLNK='frame', SLNK2='piston', SLX=0.0, SLY=0.01, SLANG=0.0 &END
 &DRIVES DRIVE='A' &END
 &METHOD DELT=0.0 &END
 &MASSES UNITL=1.0 &END
 &TIME TEND=0.2 &END
"""
# Runs that end with status 1 after a second, without NaN (found by random input): program, text, what is said. The first took 50 s, in
# short steps that were all good, the second 39 s, with matrices that had overflowed.
ENDS = [
    ("psalm", UMBRELLA, "the linkage does not close at 1 of 2 positions"),
    ("ssics", THIN, "it grows too much in a turn to be followed"),
    ("kalm", MASSLESS, "some motion of the free drives moves no mass"),
]


def ends(place):
    name = os.path.join(place, "case.nml")
    for program, text, said in ENDS:
        with open(name, "w", encoding="utf-8") as file:
            file.write(text)
        done = subprocess.run([os.path.join(BIN, program), name], capture_output=True, text=True, check=False,
                              preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_CPU, (10, 10)))
        check("ends: " + said, done.returncode == 1, (done.returncode, done.stderr))
        check("said: " + said, said in done.stderr, done.stderr)
        check("no NaN: " + said, "nan" not in (done.stdout + done.stderr).lower(), done.stderr)


def doubts(place):
    name = os.path.join(place, "case.nml")
    for cases, wanted in ((DOUBTS, True), (SILENT, False)):
        for program, base, old, new, said in cases:
            text = base.replace(old, new)
            check("something is changed", text != base, old)
            with open(name, "w", encoding="utf-8") as file:
                file.write(text)
            done = subprocess.run([os.path.join(BIN, program), name], capture_output=True, text=True, check=False)
            check("runs: " + said, done.returncode in (0, 1), (done.returncode, done.stderr))
            check(("said: " if wanted else "not said: ") + said, (said in done.stderr) == wanted, done.stderr)


def main():
    with tempfile.TemporaryDirectory() as place:
        name = os.path.join(place, "case.nml")
        for program, base, old, new, said in [("psalm", *mistake) for mistake in MISTAKES] + REFUSED:
            text = base.replace(old, new)
            check("something is changed", text != base, old)
            with open(name, "w", encoding="utf-8") as file:
                file.write(text)
            done = subprocess.run([os.path.join(BIN, program), name], capture_output=True, text=True, check=False)
            check("refused: " + said, done.returncode == 2, (done.returncode, done.stderr))
            check("said: " + said, said in done.stderr, done.stderr)
            check("nothing is written: " + said, os.listdir(place) == ["case.nml"], os.listdir(place))
        for written in os.listdir(place):
            os.remove(os.path.join(place, written))
        doubts(place)
        ends(place)
    return report()


if __name__ == "__main__":
    sys.exit(main())
