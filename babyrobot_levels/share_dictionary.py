"""What share codes of version 1 are packed with: words and fields that many levels have.

Every code of version 1 is read with these very bytes. A change, however small, would break all
codes that are in the world: other bytes need another version.
"""

from __future__ import annotations

# What is likeliest stands last: the packer says in fewer bits what lies nearer.
DICTIONARY_1 = (
    # English, and what one says of grid worlds.
    " without between other others always never only again around inside outside behind above"
    " below first second third last next under middle corner centre edge side sides garden island"
    " river bridge tower castle castles lake water ice snow rain fire lava wind glass door doors"
    " key room rooms hole holes cliff trap traps goal treasure shortcut detour corridor hallway"
    " dead end dead ends loop loops branch crossing maze mazes labyrinth grid Gridworld world"
    " level levels north south east west northern southern eastern western left right top bottom"
    " wall walls open closed short shorter shortest long longer longest near far small large"
    " one two three four five six seven eight nine ten many few some every each all both more most"
    " find finds found go goes going take takes lead leads led walk walks come comes cross keep"
    " stay move moves step steps cost costs reward rewards puddle puddles slip slips slippery skid"
    " skids look solve learn best better good hard easy simple quick slow safe dry wet deep"
    " There The This Which Who What A An In On To Of It Baby Robot Frozen Lake Cliff Walking Windy"
    " is are was has have can cannot may must will with from into onto over through after before"
    " across away out up down not no than then when where which who how what why as at by for of"
    " on or in and but so that this these those its it he his them to be the a way the path the"
    " exit the start the robot of the in the to the on the and the is a of a with a"
    # Values of fields.
    '"#000000""#ffffff""red""green""blue""gold""orange""grey""white""black""lightblue"'
    '"black_orange""blue_green""high_contrast""print"'
    '"textbook","drawn","gymnasium","starts","looks","baby-robot","puddles","walls","maze"'
    " Sutton and Barto, Reinforcement Learning: An Introduction (2nd edition, 2018), Example "
    "Gymnasium 1.Steve Roberts, the Baby Robot articles (PyPI babyrobot 1.0.40)"
    "CC-BY-4.0MITApache-2.0BSD-3-ClauseCC0-1.0"
    # Drawings.
    "\\n+   +---+   +---+---+---+---+---+---+---+---+---+\\n| S |   |           | E |\\n"
    "+   +   +   +   +   +   +---+---+\\n|       |   | o   O |###|\\n"
    # Fields, as they stand in a level.
    '{"colors":{"base":"#","lines":"#","start":"#","start_text":"#","exit":"#","exit_text":"#",'
    '"border":"#","walls":"#","arrows":"#","text_bg":"#","text_fg":"#","blocked":"#",'
    '"puddle":"#","robot":"#"},"widths":{"padding":2,"walls":4,"border":5}}'
    '"algorithm":"depth-first","wilson","aldous-broder","kruskal","prim","growing-tree",'
    '"hunt-and-kill","recursive-division","binary-tree","sidewinder","eller","loops":0.'
    '"puddle_types":{"small":{"reward":-2,"skid":0.4},"large":{"reward":-4,"skid":0.6}},'
    '"wind":{"north":[0,0,0,1,1,1,2,2,1,0],"east":[0,"south":[0,"west":[0,'
    '"warps":[{"at":[0,0],"to":"start","when":"leave","reward":-100},{"at":[1,1],"to":[0,0]},'
    '"legend":{"~":{"color":"","reward":-1,"skid":{"probability":0.6666666666666666,'
    '"to":"sides"},"ends":true,"label":""}},"to":"others"},"to":"open"},'
    '"areas":[{"at":[1,0],"size":[1,1],"color":"","reward":-1,"skid":0.3,"ends":true,'
    '"blocked":[{"at":[0,0],"size":[2,1]},{"at":[1,1]},{"at":[2,2]}],'
    '"rewards":{"step":0,"exit":1,"bump":-1,"bounce":-1,"stay":0,"closer":0,"farther":0},'
    '"discount":0.9,"max_steps":100,"theme":"default","display":{"compass":true,'
    '"start_text":false,"exit_text":false,"coordinates":true,"bottom_panel":{"width":200,'
    '"color":"","text_color":""},"robot":{"show":false,"speed":2}}}'
    '{"version":1,"name":"","title":"The ","description":"\\n","author":"","license":"","source":'
    '"","tags":["maze","puddles"],"size":[10,10],"map":"+---","start":[0,0],"exit":"none",'
    '"exit":[[0,0],[7,7]],"maze":{"seed":"random"},"maze":{"seed":1},'
    '"walls":[{"at":[1,0],"side":"N","length":2,"pass":0.5,"color":"","width":2,"fit":true},'
    '{"at":[1,2],"side":"W"},{"at":[3,3],"side":"S"},{"at":[2,1],"side":"E"}],'
    '"openings":[{"at":[2,0],"side":"E"},{"at":[2,2],"side":"E"}],'
    '"puddles":[{"at":[4,4],"size":"large"},{"at":[1,2]},{"at":[2,2],"size":"small"}],'
    '"display":{"compass":true,"side_panel":200}}'
).encode("ascii")
