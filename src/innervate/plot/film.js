const box=document.currentScript.parentElement,film=box.querySelector('svg');
const button=box.querySelector('button'),slider=box.querySelector('input');let on=true;
const set=v=>{on=v;v?film.unpauseAnimations():film.pauseAnimations();
button.textContent=v?'Pause':'Play'};
const go=t=>{film.setCurrentTime(t);slider.value=1000*(t%cycle)/cycle};
button.onclick=()=>set(!on);
slider.oninput=()=>{set(false);film.setCurrentTime(cycle*Math.min(slider.value/1000,.9999))};
setInterval(()=>{if(on)slider.value=1000*(film.getCurrentTime()%cycle)/cycle},100);
if(matchMedia('(prefers-reduced-motion: reduce)').matches){set(false);go(.9999*cycle)}
