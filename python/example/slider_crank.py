"""The slider-crank of the README."""
import psalm

case = psalm.Case.from_text("""OFFSET SLIDER-CRANK
 &LINKS NLOOP=1, MAXARC=4, ILINK=1,-2,3,4, ILOOP=1,0,-4,1,
  ARCL=40.0,140.0,0.0,10.0, GAMA=3*0.0,270.0, NOUTLK=3, NOUTLP=1 &END
 &METHOD MOTION=3, IKIN=15 &END
""")
for angle, slide in zip(case.analyse().input, case.analyse().actual[:, 0]):
    print(f"{angle:8.1f}{slide:12.4f}")
