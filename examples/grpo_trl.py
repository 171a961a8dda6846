"""TRL's GRPO teaches a tiny language model to play by text: python examples/grpo_trl.py

The model is random at first, and its only words are calls of tools. Each move is rewarded by its
exact advantage. It needs the extra `trl`: pip install ".[trl]"
"""

from __future__ import annotations

import json
from tempfile import TemporaryDirectory

import torch
from arguments import at_least, parser_of
from datasets import Dataset
from tokenizers import Tokenizer, decoders, models, pre_tokenizers
from transformers import PreTrainedTokenizerFast, Qwen3Config, Qwen3ForCausalLM
from trl import GRPOConfig, GRPOTrainer
from trl.chat_template_utils import qwen3_chat_template

import babyrobot_levels as brl

MARKS = ["<|im_start|>", "<|im_end|>", "<|endoftext|>"]
CALLS = [
    f"<tool_call>\n{json.dumps({'name': 'move', 'arguments': {'direction': side}})}\n</tool_call>"
    for side in ("north", "east", "south", "west")
]

LEVEL = {"version": 1, "size": [3, 1], "exit": [2, 0]}
"""A corridor: short enough that a random model often comes to its end."""


class World(brl.TextWorld):
    """The level as TRL wants it: its other methods are tools."""

    def __init__(self) -> None:
        super().__init__(LEVEL, sight="words", reward="advantage", within=8)

    def get_reward(self) -> float:
        while not self.done:
            self.wait()  # Who stops early has lost what was left.
        return self.reward


def tokenizer() -> PreTrainedTokenizerFast:
    """Return one that reads bytes, and for which each call of a tool is a token."""
    vocabulary = {each: number for number, each in enumerate(pre_tokenizers.ByteLevel.alphabet())}
    found = Tokenizer(models.BPE(vocab=vocabulary, merges=[]))
    found.pre_tokenizer = pre_tokenizers.ByteLevel(add_prefix_space=False)
    found.decoder = decoders.ByteLevel()
    made = PreTrainedTokenizerFast(
        tokenizer_object=found, eos_token=MARKS[1], pad_token=MARKS[2], padding_side="left"
    )
    made.add_special_tokens({"additional_special_tokens": MARKS[:1]})
    made.add_tokens(CALLS)
    made.chat_template = qwen3_chat_template
    return made


def main() -> None:
    parser = parser_of(__doc__, steps=30, steps_help="updates of the model", level=None)
    parser.add_argument("--generations", type=at_least(2), default=8, help="episodes in an update")
    args = parser.parse_args()
    torch.manual_seed(args.seed)
    torch.set_num_threads(1)
    words = tokenizer()
    spoken = {*words.convert_tokens_to_ids([*CALLS, MARKS[1]])}
    size = {"hidden_size": 64, "intermediate_size": 128, "num_hidden_layers": 2, "head_dim": 16}
    heads = {"num_attention_heads": 4, "num_key_value_heads": 2}
    model = Qwen3ForCausalLM(Qwen3Config(vocab_size=len(words), **size, **heads))
    prompt = [{"role": "user", "content": "Play this level by calling tools.\n\n"}]
    with TemporaryDirectory() as folder:
        trainer = GRPOTrainer(
            model=model,
            processing_class=words,
            environment_factory=World,
            train_dataset=Dataset.from_list([{"prompt": prompt, "seed": 1}] * args.steps),
            args=GRPOConfig(
                output_dir=folder,
                max_steps=args.steps,
                per_device_train_batch_size=args.generations,
                num_generations=args.generations,
                learning_rate=1e-2,
                max_completion_length=4096,
                max_tool_calling_iterations=8,
                generation_kwargs={"suppress_tokens": [*{*range(len(words))} - spoken]},
                logging_steps=1,
                report_to="none",
                save_strategy="no",
                use_cpu=True,
                bf16=False,
                seed=args.seed,
            ),
        )
        trainer.train()
    rewards = [each["reward"] for each in trainer.state.log_history if "reward" in each]
    third = max(1, len(rewards) // 3)
    for name, part in (("first", rewards[:third]), ("last", rewards[-third:])):
        print(f"mean reward of the {name} {third} updates: {sum(part) / third:.2f}")


if __name__ == "__main__":
    main()
