"""The same arm, target and controller in Drake, if it is installed: `pip install drake`."""

from statistics import median

import numpy as np

import labkit as lk

from .closed_loop import SECONDS, task, timed

PAIRS = 15


def diagram(target, controller):
    """Drake's discrete plant at 1 kHz, its controller written in Python, with a log."""
    from pydrake.multibody.parsing import Parser
    from pydrake.multibody.plant import MultibodyPlant
    from pydrake.systems.analysis import Simulator
    from pydrake.systems.framework import DiagramBuilder, LeafSystem
    from pydrake.systems.primitives import LogVectorOutput

    class Controlled(LeafSystem):
        def __init__(self):
            super().__init__()
            self.DeclareVectorInputPort("state", 14)
            self.DeclareVectorOutputPort("torque", 7, self.torque)

        def torque(self, context, output):
            x, t = self.get_input_port().Eval(context), context.get_time()
            output.SetFromVector(controller(lk.State(t, x[:7], x[7:]), target(t)).value)

    builder = DiagramBuilder()
    plant = builder.AddSystem(MultibodyPlant(time_step=1e-3))
    Parser(plant).AddModelsFromString(lk.robot("left").urdf(), "urdf")
    plant.WeldFrames(plant.world_frame(), plant.GetFrameByName("base"))
    plant.mutable_gravity_field().set_gravity_vector([0.0, 0.0, -9.81])
    plant.Finalize()
    system = builder.AddSystem(Controlled())
    builder.Connect(plant.get_state_output_port(), system.get_input_port())
    builder.Connect(system.get_output_port(), plant.get_applied_generalized_force_input_port())
    ports = plant.get_state_output_port(), system.get_output_port()
    logs = [LogVectorOutput(port, builder, publish_period=1e-3) for port in ports]
    simulator = Simulator(builder.Build())

    def run():
        context = simulator.get_mutable_context()
        context.SetTime(0.0)
        for log in logs:
            log.FindMutableLog(context).Clear()
        inside = plant.GetMyMutableContextFromRoot(context)
        plant.SetPositions(inside, target(0.0).position)
        plant.SetVelocities(inside, np.zeros(7))
        simulator.Initialize()
        simulator.AdvanceTo(SECONDS)
        return plant.GetPositions(inside)

    return run


def measure():
    """Speed of `run` on MuJoCo as a multiple of Drake's speed; None without Drake."""
    try:
        import pydrake  # noqa: F401
    except ImportError:
        return {"closed_loop_vs_drake_python": None}
    target, controller = task()
    in_drake, ratios = diagram(target, controller), []
    with lk.Arm("left", world=lk.World(engine="mujoco")) as arm:
        for _ in range(PAIRS):
            arm.reset(target(0.0).position)
            labkit_s, log = timed(lambda: lk.run(arm, target, controller, rate=1000))
            drake_s, q = timed(in_drake)
            if np.abs(q - log.q[-1]).max() > 1e-4:
                raise AssertionError("Drake's arm did not end where MuJoCo's did")
            ratios.append(drake_s / labkit_s)
    return {"closed_loop_vs_drake_python": median(ratios)}
