[(block) (scene_block) (shape_block) (layer_block)] @fold
