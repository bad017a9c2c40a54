"""A notebook as doctests: the Python front of the program, run and type-checked by tests/test_python.py.

The train: 0.8 and 0.2 kg m2 on a coupling of 14.4 kN m/rad, loss factor 0.1; 25 N m of order 2 at the propeller.

>>> import torsion
>>> study = torsion.build("Two discs", [
...     torsion.motor("motor", inertia=0.8),                          # a number is in SI units, a text has its unit
...     torsion.coupling("spring", stiffness="14.4 kN*m/rad", loss_factor=0.1),
...     torsion.propeller("propeller", inertia=0.2),
... ], operation={"speeds": {"from": "300 rpm", "to": "1800 rpm"}},
...    excitations=[{"at": "propeller", "order": 2, "torque": "25 N*m"}])
>>> study
Study 'Two discs': 3 components, 300 to 1800 rpm
>>> study.train
Train: 3 components (motor, spring, propeller)
>>> study.train["spring"].kind, study.train["spring"].name
('coupling', 'spring')
>>> print(study.text.splitlines()[4])                                 # a model file: save it, send it
- coupling: {name: spring, stiffness: 14.4 kN*m/rad, loss_factor: 0.1}
>>> modes = study.modes()
>>> modes
Modes: 1 elastic mode: 47.746 Hz
>>> modes.frequency_Hz.round(6).tolist()                              # sqrt(14400 / 0.16) / 2 pi
[47.746483]
>>> modes.to_dict()["frequency_Hz"] == modes.frequency_Hz.tolist()
True
>>> (modes["propeller"] / modes["motor"]).round(9).tolist()           # no angular momentum: -0.8 / 0.2
[-4.0]
>>> response = study.response()
>>> torque = response["spring"]
>>> torque
Torque of spring [N m]: 201 at 1432.4 rpm; order 2
>>> round(torque.max(), 4), round(torque.at_max_rpm, 2)               # 25 * 0.8 * sqrt(1 + 1/0.1**2)
(200.9975, 1432.39)
>>> torque.complex_Nm.shape == (torque.speed_rpm.size, 1)             # (speeds, orders)
True
>>> response["spring", 2].abs_Nm.shape == torque.speed_rpm.shape
True
>>> response["springs"]
Traceback (most recent call last):
    ...
KeyError: "no component is called 'springs'; did you mean 'spring'?"
>>> stiffer = study.with_({"spring.stiffness": 2e4})                  # the paths of `cases: set`
>>> [round(variant.critical_rpm(2)[0], 1) for variant in (study, stiffer)]
[1432.4, 1688.1]
>>> [round(study.with_({"spring.stiffness": k}).critical_rpm(2)[0], 1) for k in (1e4, 1.6e4, 2.5e4)]
[1193.7, 1509.9, 1887.3]
>>> stiffer.changes
(Change(what='spring.stiffness', before='14.4 kN*m/rad', after='20000'),)
>>> study.with_({"spring.stifness": 2e4})                             # the line of the changed file, with its fault
Traceback (most recent call last):
    ...
torsion.errors.InputError: train.yaml:5:72: unknown key `stifness` (did you mean `stiffness`?)
    - coupling: {name: spring, stiffness: 14.4 kN*m/rad, loss_factor: 0.1, stifness: 20000.0}
                                                                           ^
>>> findings = study.run()
>>> findings.verdict, findings.passed, findings.failed                # no rule was requested
('NOT JUDGED', None, False)
>>> findings["response"]["spring"].max() == torque.max()
True
>>> [path.name for path in findings.report("out") if path.suffix in (".html", ".json")]
['report.html', 'results.json']
>>> findings.figures["torque-1-0"].caption                            # .svg, .csv, .to_matplotlib()
'Vibratory torque in spring, coupling'
>>> shaft = {"length": 3.4, "diameter": 0.11, "shear_modulus": 79.3e9}
>>> round(float(torsion.formulas.round_shaft_stiffness(**shaft)), 1)
335247.0
>>> [name for name in dir(torsion) if name.startswith("c")]
['check', 'compare', 'compressor', 'coupling']
"""
