"""TorchRL's PPO learns a level with action masks. It needs: pip install ".[torchrl]"."""

import torch
from arguments import parsed, parser_of
from comparison import print_comparison
from gymnasium.vector import AutoresetMode
from tensordict import TensorDict
from tensordict.nn import TensorDictModule
from torch import nn
from torchrl.collectors import Collector
from torchrl.envs import Compose, DTypeCastTransform, GymWrapper, InitTracker, TransformedEnv
from torchrl.modules import MaskedCategorical, ProbabilisticActor, ValueOperator
from torchrl.objectives import ClipPPOLoss
from torchrl.objectives.value import GAE

import babyrobot_levels as brl


def network(num_states: int, num_outputs: int) -> nn.Sequential:
    first, last = nn.Embedding(num_states, 64), nn.Linear(64, num_outputs)
    return nn.Sequential(first, nn.Tanh(), nn.Linear(64, 64), nn.Tanh(), last)


args = parsed(parser_of(__doc__, steps=122_880))
level, mdp = args.level, args.level.compile()
torch.set_num_threads(1)  # small networks learn fastest on one
torch.manual_seed(args.seed)
mode, limit = AutoresetMode.DISABLED, level.max_steps or 500  # TorchRL itself resets what is over
envs = brl.LevelVectorEnv(
    level, num_envs=64, observation="index", max_episode_steps=limit, autoreset_mode=mode
)
read = GymWrapper(envs, categorical_action_encoding=True).auto_register_info_dict()
as_bool = DTypeCastTransform(torch.int8, torch.bool, ["action_mask"])
env = TransformedEnv(read, Compose(as_bool, InitTracker()))
env.set_seed(args.seed)

logits = TensorDictModule(network(mdp.num_states, mdp.num_actions), ["observation"], ["logits"])
keys = {"logits": "logits", "mask": "action_mask"}
policy = ProbabilisticActor(
    logits, keys, distribution_class=MaskedCategorical, return_log_prob=True
)
value = ValueOperator(network(mdp.num_states, 1), ["observation"])
# The default, smooth_l1, learns values of -500 too slowly.
loss = ClipPPOLoss(policy, value, loss_critic_type="l2", normalize_advantage=True)
advantages = GAE(gamma=level.discount, lmbda=0.95, value_network=value)
optimizer = torch.optim.Adam(loss.parameters(), 3e-3)
for batch in Collector(env, policy, frames_per_batch=4096, total_frames=args.steps):
    rows = advantages(batch).reshape(-1)
    for part in torch.stack([torch.randperm(4096) for _ in range(8)]).view(-1, 512):
        terms = loss(rows[part])
        optimizer.zero_grad()
        (terms["loss_objective"] + terms["loss_critic"] + terms["loss_entropy"]).backward()
        nn.utils.clip_grad_norm_(loss.parameters(), 0.5)
        optimizer.step()

masks = torch.tensor(mdp.action_mask, dtype=torch.bool)
states = TensorDict(observation=torch.arange(len(masks)), action_mask=masks, batch_size=len(masks))
chances = policy.get_dist(states).probs.detach().numpy()
greedy = chances.argmax(axis=1).reshape(mdp.shape)
print_comparison(level, {"learned, as it explores": chances, "learned, greedy": greedy})
