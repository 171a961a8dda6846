"""TorchRL's MAPPO learns a level of several robots. It needs: pip install ".[torchrl]"."""

import torch
from arguments import parsed, parser_of
from comparison import print_teams
from gymnasium.vector import AutoresetMode
from tensordict import TensorDict
from tensordict.nn import TensorDictModule
from torch import nn
from torchrl.collectors import Collector
from torchrl.envs import DTypeCastTransform, GymWrapper, TransformedEnv
from torchrl.modules import MaskedCategorical, MultiAgentMLP, ProbabilisticActor
from torchrl.objectives import MAPPOLoss

import babyrobot_levels as brl

BATCH = 8192  # steps of all environments between two updates
DISCOUNT = 0.99  # without one, a robot that waits for ever has no return


def network(states: int, robots: int, outputs: int, *, together: bool) -> nn.Sequential:
    """Return outputs of each robot: of what it sees alone, or of what all see."""
    sizes = {"n_agent_inputs": states, "depth": 2, "num_cells": 64, "activation_class": nn.Tanh}
    kind = {"centralized": together, "share_params": together}
    layers = MultiAgentMLP(n_agents=robots, n_agent_outputs=outputs, **sizes, **kind)
    seen = nn.Embedding.from_pretrained(torch.eye(states).repeat(1, robots))  # one-hot, for each
    return nn.Sequential(seen, nn.Unflatten(-1, (robots, states)), layers)


args = parsed(parser_of(__doc__, steps=131_072, level="two-pads"))
level, mdp = args.level, args.level.compile()
torch.set_num_threads(1)  # small networks learn fastest on one
torch.manual_seed(args.seed)
mode, limit = AutoresetMode.DISABLED, level.max_steps or 200  # TorchRL itself resets what is over
envs = brl.TeamVectorEnv(
    level, num_envs=512, observation="index", max_episode_steps=limit, autoreset_mode=mode
)
read = GymWrapper(envs, categorical_action_encoding=True).auto_register_info_dict()
env = TransformedEnv(read, DTypeCastTransform(torch.int8, torch.bool, ["action_mask"]))
env.set_seed(args.seed)

count, robots = mdp.num_states, mdp.num_robots
actors = network(count, robots, 5, together=False)
logits = TensorDictModule(actors, ["observation"], ["logits"])
keys = {"logits": "logits", "mask": "action_mask"}
policy = ProbabilisticActor(
    logits, keys, distribution_class=MaskedCategorical, return_log_prob=True
)
critic = network(count, robots, 1, together=True)
value = TensorDictModule(critic, ["observation"], ["state_value"])
loss = MAPPOLoss(policy, value, loss_critic_type="l2", entropy_coeff=0.05)
loss.make_value_estimator(gamma=DISCOUNT, lmbda=0.95)
optimizer = torch.optim.Adam(loss.parameters(), 3e-3)
for batch in Collector(env, policy, frames_per_batch=BATCH, total_frames=args.steps):
    with torch.no_grad():
        rows = loss.value_estimator(batch).reshape(-1)
    for part in torch.stack([torch.randperm(BATCH) for _ in range(4)]).view(-1, 1024):
        terms = loss(rows[part])
        optimizer.zero_grad()
        (terms["loss_objective"] + terms["loss_critic"] + terms["loss_entropy"]).backward()
        nn.utils.clip_grad_norm_(loss.parameters(), 0.5)
        optimizer.step()

joint = torch.tensor(mdp.action_mask > 0).view(-1, *[5] * robots)  # of each robot, what is allowed
masks = [joint.movedim(each + 1, 1).flatten(2).any(2) for each in range(robots)]
states = TensorDict(observation=torch.arange(count), action_mask=torch.stack(masks, 1))
chances = policy.get_dist(states.auto_batch_size_()).probs.detach().numpy().swapaxes(0, 1)
greedy = chances.argmax(axis=2)
learned = {"learned, as they explore": [*chances], "learned, greedy": [*greedy]}
print_teams(level, learned, DISCOUNT)
